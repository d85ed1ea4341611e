#include <gtest/gtest.h>

#include <cstdlib>

#include "core/base/file.h"
#include "core/store/store.h"
#include "core/store/table.h"
#include "tests/store/builders.h"
#include "tests/support/folders.h"

namespace mocurate {
namespace {

using store::Field;
using store::Presence;
using store::Schema;

const char kIntroduction[] = R"(# Store format

Files of mocurate are HDF5 and can be read with h5py or h5dump. This page is made from the table of fields that writes
and checks them (`core/store/table.cpp`); `MOCURATE_REGENERATE=1 test_store --gtest_filter='StoreFormat*'` regenerates it.

- Packed: the frames of all clips are concatenated; clip `i` is the rows `offset[i]` to `offset[i] + count[i]`.
- `@name` is an attribute of the root. Types: f4, f8 little-endian IEEE; i4, i8 signed; u1 unsigned; text is UTF-8 (bytes
  that are not UTF-8 are kept as they are), written with fixed length and zero padding, read with variable length as well.
- Quaternions are Hamilton, (w, x, y, z), unit. World: right-handed, y up, canonical facing +z.
- Same content, same bytes: no times, no compression, HDF5 library bounds 1.8 to 1.10 (metadata with checksums). A foreign
  file may be chunked and compressed with deflate, shuffle, fletcher32. Soft and external links are not followed.
- The whole file is checked when it is opened: presence, type, shape, rule, hashes. An error names file and field.
- Unknown fields are ignored, and are not part of `content_sha256`. A dataset made of datasets keeps them: rows of
  `/clips/X` and `/frames/X` follow their clips ([datasets](datasets.md)).

Presence: *always*; *optional*; *group*: all fields of the group or none; *motion*: when `@kinematics` is not `none`;
*tree*: when `@kinematics` is `tree`, and only then.

## content_sha256

One line per present field of the table except `@content_sha256`, in byte order of the paths: path, type, extents
joined by commas, SHA-256 of the values (little-endian bytes; of texts: each followed by a zero byte). `content_sha256` is the SHA-256
of these lines. Each dataset that mocurate writes carries its own as attribute `sha256`; a foreign writer may omit that.

```python
def content_sha256(fields):  # {"/clips/label": (type, array or list of bytes)}; "/@schema": ("text", b"mocurate/1")
    lines = hashlib.sha256()
    for path in sorted(fields):
        kind, values = fields[path]
        array = np.array(values, dtype=object if kind == "text" else "<" + kind)
        data = b"".join(text + b"\0" for text in array.flat) if kind == "text" else array.tobytes()
        shape = ",".join(map(str, array.shape))
        lines.update(f"{path} {kind} {shape} {hashlib.sha256(data).hexdigest()}\n".encode())
    return lines.hexdigest()
```

## Symbols

)";

std::string PresenceText(Presence presence) {
  switch (presence) {
    case Presence::kAlways:
      return "always";
    case Presence::kOptional:
      return "optional";
    case Presence::kGroup:
      return "group";
    case Presence::kMotion:
      return "motion";
    case Presence::kTree:
      return "tree";
  }
  return "";
}

std::string RowOfField(const Field& field) {
  std::string shape;
  for (const std::string& extent : field.shape) {
    shape += (shape.empty() ? "" : ", ") + (extent == "*" ? std::string("any") : extent);
  }
  const std::string path = field.path.rfind("/@", 0) == 0 ? field.path.substr(1) : field.path;
  return "| `" + path + "` | " + std::string(store::Name(field.type)) + " | " + (shape.empty() ? "one" : shape) +
         " | " + field.unit + " | " + PresenceText(field.presence) + " | " + field.meaning + " | " + field.rule.words +
         " |\n";
}

/// What the symbols of the shapes mean.
std::vector<std::pair<std::string, std::string>> Symbols() {
  return {{"C", "clips"},
          {"F", "frames of all clips"},
          {"J", "joints"},
          {"S", "segments"},
          {"L", "labels"},
          {"P", "fine labels"},
          {"N", "findings"},
          {"M", "landmarks"},
          {"R", "given reflections"},
          {"Y", "synonyms"},
          {"H", "Lie chains"},
          {"Q", "joints of the Lie chains"},
          {"K", "tracked points"},
          {"T", "frames of the tracks"},
          {"V", "views"},
          {"D", "depth images of all views"},
          {"G", "cloud files"},
          {"E", "keypoints of a person"},
          {"W", "views with keypoints"},
          {"I", "images of all views with keypoints"},
          {"U", "people of all these images"},
          {"X", "scored motions"},
          {"Z", "features of a motion"},
          {"B", "classes of the recogniser"},
          {"O", "passes over the motions"}};
}

std::string StoreFormatDocument() {
  std::string text = kIntroduction;
  for (const auto& [symbol, meaning] : Symbols()) text += "- `" + symbol + "`: " + meaning + "\n";
  for (const Schema* schema : store::AllSchemas()) {
    text += "\n## " + schema->name + "\n\n" + schema->purpose + "\n\n";
    text += "| field | type | shape | unit | presence | meaning | rule |\n|---|---|---|---|---|---|---|\n";
    for (const Field& field : schema->fields) text += RowOfField(field);
  }
  return text;
}

const std::filesystem::path kDocument = std::filesystem::path(kSourceFolder) / "docs" / "store_format.md";

TEST(StoreFormat, StoreFormatMdMatchesTheTable) {
  const std::string document = StoreFormatDocument();
  if (std::getenv("MOCURATE_REGENERATE") != nullptr) {
    const Status made = WriteFile(kDocument, document);
    ASSERT_TRUE(made) << made.error().Message();
  }
  const auto written = ReadFile(kDocument);
  ASSERT_TRUE(written) << written.error().Message();
  EXPECT_TRUE(*written == document) << "run MOCURATE_REGENERATE=1 test_store --gtest_filter='StoreFormat*'";
}

TEST(StoreFormat, EveryFieldIsInTheDocument) {
  const std::string document = StoreFormatDocument();
  for (const store::Schema* schema : store::AllSchemas()) {
    EXPECT_NE(document.find("## " + schema->name + "\n"), std::string::npos);
    for (const store::Field& field : schema->fields) {
      const std::string path = field.path.rfind("/@", 0) == 0 ? field.path.substr(1) : field.path;
      EXPECT_NE(document.find("| `" + path + "` |"), std::string::npos) << field.path;
      EXPECT_FALSE(field.meaning.empty()) << field.path;
    }
  }
}

}  // namespace
}  // namespace mocurate
