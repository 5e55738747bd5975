"""`python -m redman`: the command-line tool."""
from ._tool import main

if __name__ == "__main__":
    main()
