"""The page of a replay: how predicted and measured touchdowns of one bag or of thousands compare."""
