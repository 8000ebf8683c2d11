"""Mutants: small faults put into a copy of the sources, and whether a test finds each of them.

``python -m mutants`` in `tests` draws them, builds them all into one copy and runs tests on each; it goes on
where it ended, prints the survivors and writes the score. `make mutants` does it with all that it needs.

| file | knows |
|---|---|
| `rules`, `rules_python` | where in Rust, and in Python, a small rule makes a mutant |
| `draw` | which are tried: those of a seed, in core, bindings and package, and those named in `named.toml` |
| `build` | the copy that holds all of them, its switch (`switch.rs`, `switch.py`), and what compiles |
| `in_pytest` | pytest with one test after the other on each mutant that it reaches |
| `__main__` | the run, its record, and the score |
| `score.md` | what the last run found, by part and kind, and the mutants that live |
| `equivalent.toml` | survivors, first those that no test can kill, and why |
"""
