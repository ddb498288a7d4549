"""Bodies, moments and fields of a run as a page in a browser draws them.

Public: `scene.scene`, `packing.packed`, `packing.packed_values`, `topics.TOPICS`, `topics.Topic`.
"""
