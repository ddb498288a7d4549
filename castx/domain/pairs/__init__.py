"""Pairs of facing nodes of two bodies.

Public: `node_pairs.NodePairs`, `node_pairs.node_pairs`, `face_pairs.face_pairs`, `facing.faced`,
`sharing.shared_pairs`, `patches.pairs_by_patch`, `pairing.case_pairs`, `pairing.paired`,
`pairing.pairs_of`, `pairing.interface_pairs`, `pairing.initial_gap`, `areas.area_text`,
`areas.area_warning`.
"""
