"""Pairs of facing nodes of two bodies.

Public: `node_pairs.NodePairs`, `node_pairs.node_pairs`, `face_pairs.face_pairs`,
`patches.pairs_by_patch`, `pairing.paired`, `pairing.interface_pairs`, `pairing.initial_gap`.
"""
