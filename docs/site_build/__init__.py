"""Builds the documentation as a site: `mkdocs build --strict` calls `docs/site_build/hooks.py`.

What the code knows is generated from it at each build and never stored, so it cannot be older than the code. A module
for each part: `site_files` (what a generated file is), `markdown` (how text becomes Markdown); pages of `commands`,
`python_names`, `messages`, `schemas`, `grammar_diagrams` (read by `grammar_notation`) and the `gallery` (with
`verdicts`); `links` from the repository to the site, and `listings`, files of the repository as pages; `highlighting`
and `docstrings`, what other programs need to read; `contents`, all of it together. Two commands look at what was
built: `check_links` and `in_browser`.
"""
