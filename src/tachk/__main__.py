from tachk.cli.main import run

run()
