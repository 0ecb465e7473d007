# make demo    a picture to a pattern; the bundled patterns encoded, decoded, draped and drawn
# make test    all tests that need no pattern files by others: some minutes
# make golden  the golden files of the tests, written anew: look at the difference
# make check   format, lint, types, quick tests: before every commit
# make coverage  line coverage of these tests, at least 90 %: htmlcov/index.html
# make docs    the documentation site, without the net, warnings are errors: site/index.html
# make dist    wheel and source distribution in dist/, tried in an empty environment
# make check-kernels  compiled code on degenerate patterns, its array bounds checked: some minutes
# make corpus  the tests on pattern files by others, where ../shared or GARMENTIMAGE_CORPUS has them
# make picture the pictures of README and site, drawn anew
# make explore networks of docs/benchmarks/latent-space.md, trained anew and measured: about 5 hours
#              on two cores
# make image   networks of docs/benchmarks/prediction.md, likewise: about a day
# make text    networks of docs/benchmarks/text-editing.md, likewise; SHORT=yes: an hour and a half
# make bench   encode, decode, import and start, timed on one core

OLDEST_TO_NEWEST := (3, 11) <= sys.version_info[:2] <= (3, 13)
PYTHON ?= $(shell for p in python3 python3.13 python3.12 python3.11; do \
	$$p -c 'import sys; sys.exit(not $(OLDEST_TO_NEWEST))' 2>/dev/null && echo $$p && break; done)
VENV := .venv
BIN := $(VENV)/bin
INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt
WORKERS ?= 2
PYTEST := $(BIN)/python -m pytest -n $(WORKERS) --dist loadgroup

.PHONY: demo test golden check check-kernels coverage docs dist lint types-of-package types-of-scripts corpus picture explore image text bench clean

demo: $(VENV)/ready
	$(BIN)/python scripts/demo.py out/demo

test: $(VENV)/ready-dev
	$(PYTEST) -m "not corpus"

golden: $(VENV)/ready-dev
	$(BIN)/python -m pytest tests/test_golden.py --regold

# Calls are not held to their annotations here, as for users: `make test` does that. It also runs
# what trains networks, builds datasets or runs the commands of the documents.
LONG_TESTS := $(addprefix --ignore=tests/,dataset evaluate latent learn predict text_edit test_documents.py)
check: lint
	GARMENTIMAGE_SHAPE_CHECKS=0 $(PYTEST) -m "not slow and not corpus" $(LONG_TESTS)

# Of what is run by hand, names and arguments are checked, so that no rename breaks it.
LOOSE := --allow-untyped-defs --allow-incomplete-defs --allow-untyped-calls --allow-any-generics \
	--no-warn-return-any --no-warn-unused-ignores --allow-subclassing-any --implicit-reexport \
	$(addprefix --disable-error-code=,arg-type assignment misc operator \
		return-value union-attr var-annotated)
lint: $(VENV)/ready-dev
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(MAKE) --jobs=2 types-of-package types-of-scripts

types-of-package: $(VENV)/ready-dev
	$(BIN)/mypy src

# A cache of its own, which keeps apart what was checked with other options.
types-of-scripts: $(VENV)/ready-dev
	$(BIN)/mypy --cache-dir .mypy_cache/scripts $(LOOSE) scripts benchmarks

# A cache of its own: numba does not ask how what it has there was compiled.
KERNEL_TESTS := tests/test_kernels.py tests/raster/test_lattice.py tests/raster/test_decode_refit.py \
	tests/drape/test_mesh.py tests/drape/test_intersections.py tests/render/test_worn.py
check-kernels: $(VENV)/ready-dev
	NUMBA_BOUNDSCHECK=1 NUMBA_CACHE_DIR=$(VENV)/numba-bounds $(BIN)/python -m pytest \
		-m "not slow and not corpus" $(KERNEL_TESTS)

coverage: $(VENV)/ready-dev
	$(PYTEST) -m "not corpus" --cov --cov-report=term:skip-covered --cov-report=html

docs: $(VENV)/ready-docs
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet

dist: $(VENV)/ready
	$(INSTALL) build
	rm -rf dist build
	$(BIN)/python -m build --outdir dist .
	$(BIN)/python scripts/try_wheel.py dist

corpus: $(VENV)/ready-dev
	$(PYTEST) -m corpus

picture: $(VENV)/ready
	$(BIN)/garmentimage show --round-trip src/garmentimage/examples/dress.json \
		-o docs/images/pattern-raster-pattern.png
	$(BIN)/garmentimage gallery -o docs/images/gallery.png
	$(BIN)/python scripts/draw_worn.py docs/images/worn.png
	$(BIN)/python scripts/draw_algorithms.py docs/images
	$(BIN)/python scripts/draw_cloth_on_cloth.py docs/images/cloth-on-cloth.png
	mkdir -p out && for kind in one-panel-jumpsuit top-pants one-panel-dress; do \
		$(BIN)/garmentimage draft $$kind -o out/$$kind.json; done
	$(BIN)/garmentimage transfer out/one-panel-jumpsuit.json out/top-pants.json \
		out/one-panel-dress.json -o out/edit && cp out/edit/strip.png docs/images/edit.png
	$(BIN)/garmentimage draft top-skirt --sleeves set-in --sleeve-length 0.6 --neckline v \
		--skirt-flare 0.3 --skirt-length 0.6 -o out/worn.json
	$(BIN)/garmentimage drape out/worn.json -o out/worn.glb
	$(BIN)/garmentimage render out/worn.glb --size 512 --colour top=teal bottom=darkslateblue \
		-o src/garmentimage/examples/worn.png
	$(BIN)/garmentimage predict src/garmentimage/examples/worn.png -o out/picture && \
		cp out/picture/worn.png docs/images/from-a-picture.png

explore: $(VENV)/ready-dev
	set -e; for each in "topology 5000 40 60" "darts 5000 40 60" "variety 10000 24 30"; do \
		set -- $$each; data=data/vae-$$1-$$2; \
		$(BIN)/garmentimage build vae-$$1 --count $$2 -o $$data; \
		$(BIN)/garmentimage train vae --data $$data --epochs $$3 \
			-o runs/vae-$$1; \
		$(BIN)/garmentimage train vector-vae --data $$data --epochs $$4 -o runs/vector-vae-$$1; \
		$(BIN)/garmentimage evaluate latent --data $$data --vae runs/vae-$$1/model \
			--vectors runs/vector-vae-$$1/model -o runs/explore-$$1; \
	done

image: $(VENV)/ready-dev
	scripts/image.sh $(BIN)/garmentimage

text: $(VENV)/ready-dev
	scripts/text.sh $(BIN)/garmentimage

bench: $(VENV)/ready
	$(BIN)/python benchmarks/speed.py

clean:
	rm -rf $(VENV) out site dist build htmlcov .coverage

# One environment for all of it; made again when a dependency changes.
$(VENV)/made:
	@test -n "$(PYTHON)" || { echo "garmentimage needs Python 3.11, 3.12 or 3.13;" \
		"name one: make PYTHON=/path/to/python3.12" >&2; exit 1; }
	@$(PYTHON) -c 'import sys; sys.exit(not $(OLDEST_TO_NEWEST))' || { echo "$(PYTHON) is" \
		"not Python 3.11, 3.12 or 3.13; name one: make PYTHON=python3.12" >&2; exit 1; }
	$(PYTHON) -m venv $(VENV)
	touch $@

$(VENV)/ready: $(VENV)/made pyproject.toml constraints.txt
	$(INSTALL) -e .
	touch $@

$(VENV)/ready-dev: $(VENV)/ready
	$(INSTALL) -e ".[dev]"
	touch $@

$(VENV)/ready-docs: $(VENV)/ready
	$(INSTALL) -e ".[docs]"
	touch $@
