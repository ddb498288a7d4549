"""`python -m castx` is the command `castx`."""

from castx.cli import main

main()
