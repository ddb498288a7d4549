"""Material data for foundry quantities beside thermal and mechanical data.

Public: `entries.ArmSpacingData`, `entries.StrengthData`, `entries.FatigueData`.
"""
