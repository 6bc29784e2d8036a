"""Mutation testing of the crate: which of cargo-mutants' mutants its tests kill, without a build for each.

    cargo install cargo-mutants --locked
    python3 fuzz/mutants.py --every 16 --first 8 --work /tmp/mutants

cargo-mutants lists every mutant, and every 16th is tested, evenly over all files. The mutated bodies of a function are built
next to its own body, and an environment variable selects the one that runs: one build for all. Mutants that cannot be built
in this way (constants, `const fn`, bodies of another type) are built one by one. A mutant that does not compile is unviable.

A mutant is killed by the first test program that fails, or that takes ten times as long as without it and at least 20 s. The
crate's own tests run first. The surviving mutants are tested with the harness's tests in --then. Tests that compare the host
with an image are left out: the image is never mutated, so any change of a bit would fail there. The script writes only to the
folder of --work, which should be outside of the project: a copy of --commit, results.json, and the builds, unless
CARGO_TARGET_DIR specifies another folder. Nothing else may build there at the same time, because its programs would replace
the tested ones.
"""

import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import time

SWITCH = """
#[doc(hidden)]
#[allow(missing_docs)]
pub mod mutant_switch {
    #[cfg(not(target_os = "none"))]
    pub fn on(mutant: u32) -> bool {
        extern crate std;
        static RUNNING: std::sync::OnceLock<u32> = std::sync::OnceLock::new();
        *RUNNING.get_or_init(|| std::env::var("MUTANT").map_or(0, |number| number.parse().unwrap_or(0))) == mutant
    }
    #[cfg(target_os = "none")]
    pub fn on(_: u32) -> bool {
        false
    }
}
"""
# Tests that take minutes by themselves, and tests against an image.
LEFT_OUT = {"long_run"}
SKIPPED = "on_the_image"
LEAST_TIMEOUT = 20.0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--every", type=int, default=16, metavar="N")
    parser.add_argument("--first", type=int, default=0, metavar="K", help="of each N, from 0")
    parser.add_argument("--file", action="append", default=[], metavar="GLOB", help="of these files only, such as src/rig/**")
    parser.add_argument("--then", nargs="*", default=["faults"], metavar="TEST", help="modules of the simulated rig's tests (default: faults)")
    parser.add_argument("--commit", default="HEAD")
    parser.add_argument("--work", type=pathlib.Path, required=True)
    options = parser.parse_args()
    built = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", options.work / "target"))
    tree = Tree(options.work / "tree", built)
    tree.copy(options.commit)
    mutants = tree.mutants(options.first, options.every, options.file)
    print(f"{len(mutants)} mutants", flush=True)
    alone = tree.switch_in(mutants)
    programs = tree.programs(options.then)
    if programs is None:
        sys.exit("the tests do not build")
    for number, mutant in mutants.items():
        if number in alone:
            continue
        mutant["killed_by"] = first_that_fails(programs, number)
        tell(number, mutant)
    for number in sorted(alone):
        mutant = mutants[number]
        mutant["killed_by"] = tree.alone(mutant, options.then, programs)
        tell(number, mutant)
    rows = [{key: mutant[key] for key in ("name", "file", "killed_by")} for mutant in mutants.values()]
    (options.work / "results.json").write_text(json.dumps(rows, indent=1) + "\n")
    viable = [row for row in rows if row["killed_by"] != "unviable"]
    killed = sum(row["killed_by"] is not None for row in viable)
    print(f"{killed} of {len(viable)} viable mutants killed, {len(rows) - len(viable)} unviable")


def tell(number, mutant):
    print(f"{number:5} {mutant['killed_by'] or 'LEFT':20} {mutant['name']}", flush=True)


class Program:
    """A built test, and its run time without a mutant."""

    def __init__(self, name, path, folder, seconds=None, modules=()):
        self.name, self.path, self.folder, self.modules = name, path, folder, [f"{module}::" for module in modules]
        began = time.monotonic()
        if seconds is None and not self.passes(0, 3600.0):
            sys.exit(f"{name} fails without any mutant")
        self.seconds = time.monotonic() - began if seconds is None else seconds

    def passes(self, mutant, timeout):
        # A seed that proptest stored would make the tests stronger for the next mutants.
        environment = {**os.environ, "MUTANT": str(mutant), "PROPTEST_DISABLE_FAILURE_PERSISTENCE": "true"}
        environment.pop("CI", None)
        running = subprocess.Popen(
            [self.path, "--quiet", "--skip", SKIPPED, *self.modules],
            cwd=self.folder,
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        try:
            return running.wait(timeout) == 0
        except subprocess.TimeoutExpired:
            os.killpg(running.pid, 9)
            running.wait()
            return False


def first_that_fails(programs, mutant):
    for program in programs:
        if not program.passes(mutant, max(LEAST_TIMEOUT, 10.0 * program.seconds)):
            return program.name
    return None


class Tree:
    """A copy of the project, to be mutated."""

    def __init__(self, root, target):
        self.root, self.target = root.resolve(), target.resolve()

    def cargo(self, *words):
        environment = {**os.environ, "CARGO_TARGET_DIR": str(self.target)}
        return subprocess.run(["cargo", *words], cwd=self.root, env=environment, stdout=subprocess.PIPE, text=True)

    def copy(self, commit):
        subprocess.run(["rm", "-rf", self.root], check=True)
        self.root.mkdir(parents=True)
        archive = subprocess.Popen(["git", "archive", commit], stdout=subprocess.PIPE)
        subprocess.run(["tar", "-x", "-C", self.root], stdin=archive.stdout, check=True)

    def mutants(self, first, every, files):
        chosen = [word for file in files for word in ("--file", file)]
        shard = ["--shard", f"{first}/{every}", "--sharding", "round-robin"]
        listed = self.cargo("mutants", "-p", "mesh-damper", *chosen, *shard, "--list", "--json")
        return dict(enumerate(json.loads(listed.stdout), start=1))

    def switch_in(self, mutants):
        """Builds all mutants into one program, and returns those that must be built alone."""
        sources = {mutant["file"]: (self.root / mutant["file"]).read_text() for mutant in mutants.values()}
        library = self.root / "src/lib.rs"
        without = library.read_text()
        bodies = {number: body(sources[mutant["file"]], mutant) for number, mutant in mutants.items()}
        alone = {number for number, mutant in mutants.items() if bodies[number] is None or within_another(number, mutants, bodies)}
        while True:
            places = {}
            for file, source in sources.items():
                of_file = {n: m for n, m in mutants.items() if m["file"] == file and n not in alone}
                mutated, lines = with_all(source, of_file)
                (self.root / file).write_text(mutated)
                places[file] = lines
            library.write_text((without if "src/lib.rs" not in sources else library.read_text()) + SWITCH)
            refused = self.refused(places)
            if not refused:
                self.sources = {**sources, "src/lib.rs": sources.get("src/lib.rs", without)}
                return alone
            alone |= refused
            print(f"{len(refused)} do not compile beside the others", flush=True)

    def refused(self, places):
        """The mutants at the places of the compiler's errors. For an error elsewhere in a function, all of that function's mutants."""
        checked = self.cargo("build", "--package", "mesh-damper", "--lib", "--features", "fixed-point", "--message-format", "json")
        refused, errors = set(), []
        for message in map(json.loads, checked.stdout.splitlines()):
            if message["reason"] != "compiler-message" or message["message"]["level"] != "error":
                continue
            errors.append(message["message"]["rendered"])
            for span in message["message"]["spans"]:
                if span["is_primary"]:
                    for first, last, numbers in places.get(span["file_name"], []):
                        if first <= span["line_start"] <= last:
                            refused |= numbers
                            break
        if errors and not refused:
            sys.exit("\n".join(errors))
        return refused

    def programs(self, modules, known=None):
        """The test programs: the crate's, the quickest first, and then these modules of the simulated rig's. The run times
        of a mutant that is built alone are those of the `known` programs. `None` if they do not build."""
        crate = self.built(["--package", "mesh-damper", "--lib", "--tests", "--features", "fixed-point"])
        others = self.built(["--package", "mesh-damper-rig", "--test", "rig"]) if modules else []
        if crate is None or others is None:
            return None
        seconds = {program.name: program.seconds for program in known or []}
        crate = [Program(name, path, self.root, seconds.get(name)) for name, path in crate]
        others = [Program("rig of hil", path, self.root / "hil/rig", seconds.get("rig of hil"), modules) for _, path in others]
        return sorted(crate, key=lambda program: program.seconds) + others

    def built(self, chosen):
        ran = self.cargo("test", *chosen, "--no-run", "--message-format", "json-render-diagnostics")
        if ran.returncode != 0:
            return None
        found = [message for message in map(json.loads, ran.stdout.splitlines()) if message.get("executable")]
        found = [m for m in found if m["profile"]["test"] and m["target"]["name"] not in LEFT_OUT]
        return [(m["target"]["name"], m["executable"]) for m in found]

    def alone(self, mutant, modules, known):
        for file, source in self.sources.items():
            (self.root / file).write_text(source)
        source = self.sources[mutant["file"]]
        first, last = ends(source, mutant["span"])
        (self.root / mutant["file"]).write_text(source[:first] + mutant["replacement"] + source[last:])
        programs = self.programs(modules, known)
        return "unviable" if programs is None else first_that_fails(programs, 0)


def ends(source, span):
    """Offsets of a span of lines and columns, both from 1."""
    lines = source.splitlines(keepends=True)
    at = lambda place: sum(map(len, lines[: place["line"] - 1])) + place["column"] - 1
    return at(span["start"]), at(span["end"])


def body(source, mutant):
    """Start and end of the body of its function, without braces; None if the body cannot be switched."""
    if mutant["function"] is None:
        return None
    first, last = ends(source, mutant["function"]["span"])
    close = source.rindex("}", first, last)
    depth, place = 1, close
    while depth:
        place -= 1
        depth += {"}": 1, "{": -1}.get(source[place], 0)
    if place < first or re.search(r"\bconst (unsafe )?fn\b", source[first:place]):
        return None
    changed, end = ends(source, mutant["span"])
    return (place + 1, close) if place < changed and end <= close else None


def within_another(number, mutants, bodies):
    """Whether its function is inside another one that has mutants."""
    first, last = bodies[number]
    others = (bodies[other] for other in mutants if mutants[other]["file"] == mutants[number]["file"] and bodies[other])
    return any(begin < first and last < end for begin, end in others)


def with_all(source, mutants):
    """`source` with every mutant behind a switch, and the lines of each mutant: its own first, then those of the whole function."""
    functions = {}
    for number, mutant in mutants.items():
        functions.setdefault(body(source, mutant), []).append(number)
    text, own, whole, done = "", [], [], 0
    for (first, last), numbers in sorted(functions.items()):
        text += source[done:first]
        began = text.count("\n") + 1
        for number in numbers:
            mutant = mutants[number]
            changed, end = ends(source, mutant["span"])
            text += f"\nif crate::mutant_switch::on({number}) {{"
            line = text.count("\n") + 1
            text += source[first:changed] + mutant["replacement"] + source[end:last]
            own.append((line, text.count("\n") + 1, {number}))
            text += "\n} else"
        text += " {" + source[first:last] + "}\n"
        whole.append((began, text.count("\n") + 1, set(numbers)))
        done = last
    return text + source[done:], own + whole


if __name__ == "__main__":
    main()
