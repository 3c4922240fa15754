"""A site that is not there exactly once, or that another overlaps, is an error and never another mutation."""

import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
import sites  # noqa: E402

TEXT = "float f() {\n  return a + b;\n}\nfloat g() {\n  x = y;\n  return a + c;\n}\n"
HEAD = '[[mutation]]\nname = "{name}"\narea = "other"\nseen = ["tests"]\nfile = "f.cpp"\n'


class Sites(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)
        (self.root / "f.cpp").write_text(TEXT)

    def tearDown(self):
        self.folder.cleanup()

    def mutate(self, *bodies):
        text = "".join(HEAD.format(name=f"m{i}") + body + "\n" for i, body in enumerate(bodies, 1))
        path = self.root / "suite.toml"
        path.write_text(text)
        return sites.mutate(sites.read_suite(path), self.root)["f.cpp"]

    def assert_refused(self, word, *bodies):
        with self.assertRaises(sites.SiteError) as caught:
            self.mutate(*bodies)
        self.assertIn(word, str(caught.exception))

    def test_an_expression_is_chosen_by_number(self):
        out = self.mutate("at = 'a + b'\nbe = 'a - b'")
        self.assertEqual(out, TEXT.replace("a + b", "(PeltMutated(1) ? (a - b) : (a + b))"))

    def test_a_statement_is_chosen_by_number(self):
        out = self.mutate("at = 'x = y;'\nbe = ''\nform = 'statement'")
        self.assertEqual(out, TEXT.replace("x = y;", "if (PeltMutated(1)) {  } else { x = y; }"))

    def test_several_of_one_site_become_a_chain(self):
        out = self.mutate("at = 'a + b'\nbe = '1'", "at = 'a + b'\nbe = '2'")
        self.assertIn("(PeltMutated(1) ? (1) : ((PeltMutated(2) ? (2) : (a + b))))", out)

    def test_one_of_two_is_told_by_what_stands_round_it(self):
        out = self.mutate("within = 'return a + c'\nat = 'a'\nbe = 'b'")
        self.assertEqual(out, TEXT.replace("return a + c", "return (PeltMutated(1) ? (b) : (a)) + c"))

    def test_what_is_not_there_once_is_refused(self):
        self.assert_refused("stands 0 times", "at = 'a * b'\nbe = 'a'")
        self.assert_refused("stands 2 times", "at = 'return a'\nbe = 'return b'")
        self.assert_refused("stands 2 times", "within = 'return'\nat = 'r'\nbe = 's'")
        self.assert_refused("no file", "site = [{file = 'g.cpp', at = 'a', be = 'b'}]")

    def test_overlaps_and_mistakes_are_refused(self):
        self.assert_refused("overlap", "at = 'a + b'\nbe = '1'", "at = 'a + b;'\nbe = '2;'\nform = 'statement'")
        self.assert_refused("not a whole expression", "at = 'x = y;'\nbe = 'x = 0;'")
        self.assert_refused("not a whole expression", "at = 'a + c'\nbe = ''")
        self.assert_refused("not a whole expression", "at = 'f()'\nbe = 'f('")
        self.assert_refused("not a whole statement", "at = 'x = y;'\nbe = 'x = z'\nform = 'statement'")
        self.assert_refused("nothing is changed", "at = 'a + b'\nbe = 'a + b'")
        self.assert_refused("form 'line'", "at = 'a + b'\nbe = 'a'\nform = 'line'")
        with self.assertRaises(sites.SiteError):
            path = self.root / "suite.toml"
            path.write_text((HEAD.format(name="m") + "at = 'a + b'\nbe = 'a'\n") * 2)
            sites.read_suite(path)


if __name__ == "__main__":
    unittest.main()
