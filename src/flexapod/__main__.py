"""`python -m flexapod` is the command `flexapod`."""

from flexapod.app.cli.cli import main

if __name__ == "__main__":
    main()
