"""A site that is not there exactly once, or that another overlaps, is an error and never another mutation."""

import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
import sites  # noqa: E402

TEXT = "float f() {\n  return a + b;\n}\nfloat g() {\n  x = y;\n  return a + c;\n}\n"
HEAD = "== f.cpp\nother tests: {name}\n"


class Sites(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)
        (self.root / "f.cpp").write_text(TEXT)

    def tearDown(self):
        self.folder.cleanup()

    def mutate(self, *bodies):
        text = "".join(HEAD.format(name=f"m{i}") + body + "\n" for i, body in enumerate(bodies, 1))
        path = self.root / "suite.txt"
        path.write_text(text)
        return sites.mutate(sites.read_suite(path), self.root)["f.cpp"]

    def assert_refused(self, word, *bodies):
        with self.assertRaises(sites.SiteError) as caught:
            self.mutate(*bodies)
        self.assertIn(word, str(caught.exception))

    def test_an_expression_is_chosen_by_number(self):
        out = self.mutate("- a + b\n+ a - b")
        self.assertEqual(out, TEXT.replace("a + b", "(PeltMutated(1) ? (a - b) : (a + b))"))

    def test_a_statement_is_chosen_by_number(self):
        out = self.mutate("- x = y;\n+")
        self.assertEqual(out, TEXT.replace("x = y;", "if (PeltMutated(1)) {  } else { x = y; }"))

    def test_several_of_one_site_become_a_chain(self):
        out = self.mutate("- a + b\n+ 1", "- a + b\n+ 2")
        self.assertIn("(PeltMutated(1) ? (1) : ((PeltMutated(2) ? (2) : (a + b))))", out)

    def test_one_of_two_is_told_by_what_stands_round_it(self):
        out = self.mutate("@ return a + c\n- a\n+ b")
        self.assertEqual(out, TEXT.replace("return a + c", "return (PeltMutated(1) ? (b) : (a)) + c"))

    def test_a_fault_may_have_several_sites_of_several_lines(self):
        out = self.mutate("- a + b\n+ 1\n-   x = y;\n-   return a + c;\n+")
        self.assertIn("return (PeltMutated(1) ? (1) : (a + b));", out)
        self.assertIn("if (PeltMutated(1)) {  } else {   x = y;\n  return a + c; }", out)

    def test_what_is_not_there_once_is_refused(self):
        self.assert_refused("stands 0 times", "- a * b\n+ a")
        self.assert_refused("stands 2 times", "- float\n+ double")
        self.assert_refused("stands 2 times", "@ return\n- r\n+ s")
        self.assert_refused("no file", "== g.cpp\n- a\n+ b")

    def test_overlaps_and_mistakes_are_refused(self):
        self.assert_refused("overlap", "- a + b\n+ 1", "- a + b;\n+ 2;")
        self.assert_refused("not a whole expression", "- a + c\n+")
        self.assert_refused("not a whole expression", "- f()\n+ f(")
        self.assert_refused("not a whole expression", "- x = y;\n+ x = z")
        self.assert_refused("nothing is changed", "- a + b\n+ a + b")
        self.assert_refused("neither a head nor a site", "* a + b")
        self.assert_refused("no site", "")
        with self.assertRaises(sites.SiteError):
            path = self.root / "suite.txt"
            path.write_text((HEAD.format(name="m") + "- a + b\n+ a\n") * 2)
            sites.read_suite(path)


if __name__ == "__main__":
    unittest.main()
