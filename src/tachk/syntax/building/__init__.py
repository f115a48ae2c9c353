"""From a parse to the syntax tree: one method for each rule of the grammar."""
