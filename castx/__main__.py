"""`python -m castx` is the command `castx`."""

from castx.command.cli import main

main()
