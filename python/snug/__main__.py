"""`python -m snug`: the program `snug`, where the package came as a wheel."""
from _snug_program import main

main()
