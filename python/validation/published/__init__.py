"""Published cases: what textbooks and papers say, and what comes out, of springs and of solids."""
