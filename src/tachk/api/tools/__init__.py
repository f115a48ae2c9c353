"""The tools of `tachk mcp`: functions from a JSON object to an answer, and the server that offers them to agents.

`limits` and `answer` say what every tool has, `inputs` reads what calls give, `evidence` says what was checked.
`about_models`, `about_runs` and `about_records` hold the tools, `catalogue` the table of them, `server` the protocol.
"""
