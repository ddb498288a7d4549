"""The text of a case file as the page changes it: places of its values, edits, words of the page.

Public: `toml_lines.line_of`, `editing.with_value`, `editing.with_entry`, `arguments.text_of`.
"""
