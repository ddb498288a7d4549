"""Gaps and motions of node pairs as functions of the unknowns, and which pairs are closed.

Public: `transform.ConstraintTransform`, `gaps.Gaps`, `active_set.ActiveSet`, `rigid.RigidBody`,
`pair_state.contact_state`, `hidden_pairs.hidden_pair_warnings`, `midside_shares.quadratic_pairs`
"""
