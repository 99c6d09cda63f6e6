"""`python -m crowdquilt` is the command line."""

from crowdquilt.cli import main

if __name__ == "__main__":
    main()
