"""Mutation tests: each mechanism of the method is broken in turn, and a test must notice.

    python -m tests.mutations --list
    python -m tests.mutations --workers 2 -o mutations.json
    python -m tests.mutations --only swarm.own_pull

A mutation is a row of a table: the text that is replaced, what stands in its place, the tests of which at least one
must fail. It is applied to a copy of the tree, so that the tree itself is never touched.
"""
