"""The machine on the floor: commands ahead."""
