"""What scripts/paper_section5 measures, draws and writes."""
