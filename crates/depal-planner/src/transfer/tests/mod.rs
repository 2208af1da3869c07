mod time_law;
