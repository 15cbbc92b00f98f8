"""Each module makes some of the tables that documents state: MAKERS, by the name of the table or of the group of tables that one run gives."""
