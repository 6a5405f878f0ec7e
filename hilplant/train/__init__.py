"""From the physical plant to tables, polynomials and networks that stand for it; nothing here runs in the loop."""
