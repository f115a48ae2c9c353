"""A process that has loaded tachk already: a copy of it carries out each request.

`identity` says which server a program may use, `client` is the thin way to it, `binding` makes its socket, `process` is
its life. `preload` is what it loads before requests come, `sources` notices that tachk has changed. `loop` answers the
`messages` of each `connection`; `work` is a request that is under way, `worker` the copy that carries it out, and
`inquiry` asks a server about itself. `scripts` serves a client that is no Python.
"""
