"""What foundry quantities ask of a material beside its thermal and mechanical data.

Public: `entries.ArmSpacingData`, `entries.StrengthData`, `entries.FatigueData`.
"""
