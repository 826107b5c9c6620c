"""Results of the commands: data classes whose fields are the keys of summary.json, and their description."""
