"""Pairs of facing nodes of two bodies.

Public: `node_pairs.NodePairs`, `node_pairs.node_pairs`, `facing.faced`, `sharing.shared_pairs`,
`patches.pairs_by_patch`, `pairing.case_pairs`, `pairing.pairs_of`, `pairing.Facing`,
`areas.area_text`, `areas.area_warning`, `edge_shares.edge_shares`,
`facing_edges.facing_edges`.
"""
