"""UPPAAL's files, read and written.

Reading: `reader`, on top of `xml_tree`, `xml_text`, `template_reader`, `query_reader`. Writing: `export`, `writer`
with `section_writer`, `query_writer`, `query_file`; `limits` and `portability` say what UPPAAL does not accept. Runs:
`intermediate`, `xtr`, `trace_xml`.
"""
