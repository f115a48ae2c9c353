"""From a file, in any format that is read, to a model: `model_files` for its text alone, `load` for its meaning."""
