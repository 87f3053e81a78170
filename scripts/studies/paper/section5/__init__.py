"""What scripts/studies/paper/paper_section5 measures, draws and writes."""
