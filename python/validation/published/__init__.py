"""Published cases: results of springs and of solids against values from textbooks and papers."""
