#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <map>
#include <sstream>

#include "core/base/config_parts.h"
#include "core/base/file.h"

namespace mocurate::internal {
namespace {

constexpr std::string_view kTextTag = "tag:yaml.org,2002:str";

/// yaml-cpp reads a whole [ ] or { } ahead and takes about 200 bytes for a token; each but plain text has one of these.
constexpr std::string_view kMarks = "[]{},:?&*!\"'";
constexpr std::size_t kMostMarks = 2000000;

/// Builds the tree from the events of one document.
class TreeBuilder final : public YAML::EventHandler {
 public:
  TreeBuilder(const ConfigSource& source, ProblemList& problems) : source_(source), problems_(problems) {}

  ConfigNode root;
  bool has_root = false;
  /// A limit was exceeded and reported; the rest is skipped.
  bool stopped() const { return stopped_; }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { Place(NodeAt(mark), anchor); }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    ConfigNode node = NodeAt(mark);
    node.kind = ConfigNode::Kind::kScalar;
    node.scalar = value;
    node.quoted = tag == "!" || tag == kTextTag;
    if (tag != "?" && !tag.empty() && !node.quoted) RefuseTag(mark, tag);
    Place(std::move(node), anchor);
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    if (stopped_) return;
    const auto found = anchors_.find(anchor);
    if (found == anchors_.end()) {
      problems_.Add(OriginOf(mark).Text(), "an alias is inside the value that it names", "write the value out");
      Place(NodeAt(mark), 0);
      return;
    }
    if (!CountCopy(OriginOf(mark), found->second.count, found->second.bytes)) return;
    ConfigNode copy = found->second.node;
    copy.origin = OriginOf(mark);
    Put(std::move(copy));
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    Begin(ConfigNode::Kind::kSequence, mark, tag, anchor);
  }
  void OnSequenceEnd() override { End(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    Begin(ConfigNode::Kind::kMapping, mark, tag, anchor);
  }
  void OnMapEnd() override { End(); }

 private:
  struct Level {
    ConfigNode node;
    YAML::anchor_t anchor = 0;
    bool has_key = false;
    bool drops_value = false;  ///< the key was refused
    std::string key;
    Origin key_origin;
    std::map<std::string, int> lines;  ///< of the keys so far
  };
  struct Anchored {
    ConfigNode node;
    std::size_t count;
    std::size_t bytes;
  };

  Origin OriginOf(const YAML::Mark& mark) const { return {source_.name, mark.line + 1, mark.column + 1}; }

  ConfigNode NodeAt(const YAML::Mark& mark) const {
    ConfigNode node;
    node.origin = OriginOf(mark);
    node.base_folder = source_.base_folder;
    return node;
  }

  void RefuseTag(const YAML::Mark& mark, const std::string& tag) {
    problems_.Add(OriginOf(mark).Text(), "the YAML tag " + Quoted(tag) + " has no meaning here", "leave it out");
  }

  void Stop(const Origin& origin, const std::string& what) {
    if (!stopped_) problems_.Add(origin.Text(), what);
    stopped_ = true;
  }

  /// Of an anchor's value, or for an alias.
  bool CountCopy(const Origin& origin, std::size_t count, std::size_t bytes) {
    nodes_ += count;
    copied_bytes_ += bytes;
    if (nodes_ <= kMostConfigNodes && copied_bytes_ <= kMostConfigBytes) return true;
    Stop(origin, "more than " + std::to_string(kMostConfigNodes) + " values or " +
                     std::to_string(kMostConfigBytes >> 20) + " MiB of text, anchors and aliases written out");
    return false;
  }

  void Begin(ConfigNode::Kind kind, const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
    if (stopped_) return;
    if (!tag.empty() && tag != "?" && tag != "!") RefuseTag(mark, tag);
    if (levels_.size() == kMostConfigDepth) {
      return Stop(OriginOf(mark), "nested deeper than " + std::to_string(kMostConfigDepth) + " levels");
    }
    Level level;
    level.node = NodeAt(mark);
    level.node.kind = kind;
    level.anchor = anchor;
    levels_.push_back(std::move(level));
  }

  void End() {
    if (stopped_) return;
    Level level = std::move(levels_.back());
    levels_.pop_back();
    Place(std::move(level.node), level.anchor);
  }

  void Place(ConfigNode node, YAML::anchor_t anchor) {
    if (stopped_) return;
    if (nodes_ >= kMostConfigNodes) {
      return Stop(node.origin, "more than " + std::to_string(kMostConfigNodes) + " values");
    }
    ++nodes_;
    if (anchor != 0) {
      const std::size_t count = CountOf(node), bytes = TextBytesOf(node);
      if (!CountCopy(node.origin, count, bytes)) return;
      anchors_[anchor] = {node, count, bytes};
    }
    Put(std::move(node));
  }

  void Put(ConfigNode node) {
    if (levels_.empty()) {
      root = std::move(node);
      has_root = true;
      return;
    }
    Level& level = levels_.back();
    if (level.node.kind == ConfigNode::Kind::kSequence) {
      level.node.sequence.push_back(std::move(node));
    } else if (!level.has_key) {
      TakeKey(level, node);
    } else {
      level.has_key = false;
      if (level.drops_value) return;
      node.key_origin = level.key_origin;
      if (node.kind == ConfigNode::Kind::kNull) node.origin = level.key_origin;
      level.node.mapping.emplace_back(std::move(level.key), std::move(node));
    }
  }

  void TakeKey(Level& level, const ConfigNode& node) {
    level.has_key = true;
    level.drops_value = true;
    level.key = node.scalar;
    level.key_origin = node.origin;
    const std::string where = node.origin.Text();
    if (node.kind != ConfigNode::Kind::kScalar) {
      problems_.Add(where, "a key must be a text", "put it in quotes");
    } else if (node.scalar == "<<" && !node.quoted) {
      problems_.Add(where, "the merge key '<<' is not read", "use include:, or write the values out");
    } else if (const auto [first, is_new] = level.lines.emplace(node.scalar, node.origin.line); !is_new) {
      problems_.Add(where,
                    "key " + Quoted(node.scalar) + " appears twice, first in line " + std::to_string(first->second),
                    "keep one of them");
    } else {
      level.drops_value = false;
    }
  }

  const ConfigSource& source_;
  ProblemList& problems_;
  std::vector<Level> levels_;
  std::map<YAML::anchor_t, Anchored> anchors_;
  std::size_t nodes_ = 0;
  std::size_t copied_bytes_ = 0;
  bool stopped_ = false;
};

/// Origin of a byte of the text.
Origin OriginAt(const ConfigSource& source, std::size_t offset) {
  Origin origin{source.name, 1, 1};
  for (std::size_t i = 0; i < offset; ++i) {
    ++origin.column;
    if (source.text[i] == '\n') {
      ++origin.line;
      origin.column = 1;
    }
  }
  return origin;
}

bool IsText(const ConfigSource& source, ProblemList& problems) {
  if (source.text.size() > kMostConfigBytes) {
    problems.Add(source.name, "is larger than " + std::to_string(kMostConfigBytes >> 20) + " MiB",
                 "is this a configuration?");
    return false;
  }
  if (const std::optional<std::size_t> bad = FirstNotUtf8(source.text)) {
    problems.Add(OriginAt(source, *bad).Text(), "a byte that is not UTF-8", "save the file as UTF-8");
    return false;
  }
  std::size_t marks = 0;
  for (std::size_t i = 0; i < source.text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(source.text[i]);
    if (kMarks.find(source.text[i]) != std::string_view::npos && ++marks > kMostMarks) {
      problems.Add(OriginAt(source, i).Text(),
                   "more than " + std::to_string(kMostMarks) + " brackets, quotes and other marks of YAML",
                   "is this a configuration?");
      return false;
    }
    if ((byte < 0x20 && byte != '\t' && byte != '\n' && byte != '\r') || byte == 0x7F) {
      problems.Add(OriginAt(source, i).Text(), "a control character (code " + std::to_string(byte) + ")",
                   "is this a text file?");
      return false;
    }
  }
  return true;
}

/// A line of a text, counted from 0; empty when there is none.
std::string_view LineOf(std::string_view text, int line) {
  for (int i = 0; i < line; ++i) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return {};
    text.remove_prefix(end + 1);
  }
  return text.substr(0, text.find('\n'));
}

void RunParser(const ConfigSource& source, TreeBuilder& builder, ProblemList& problems) {
  try {
    std::istringstream stream(source.text);
    YAML::Parser parser(stream);
    if (!parser.HandleNextDocument(builder)) return;
    ConfigSource rest = source;
    ProblemList ignored;
    TreeBuilder second(rest, ignored);
    if (parser.HandleNextDocument(second)) {
      problems.Add(source.name, "more than one YAML document", "keep one, and remove the line '---'");
    }
  } catch (const YAML::Exception& error) {
    if (builder.stopped()) return;
    const Origin origin{source.name, error.mark.line + 1, error.mark.column + 1};
    problems.Add(error.mark.is_null() ? source.name : origin.Text(), "not YAML: " + error.msg,
                 LineOf(source.text, error.mark.line).find("${") == std::string_view::npos
                     ? ""
                     : "inside [ ] and { }, ${...} must be in quotes");
  } catch (const std::exception& error) {
    problems.Add(source.name, std::string("not YAML: ") + error.what());
  }
}

}  // namespace

std::size_t CountOf(const ConfigNode& node) {
  std::size_t count = 1;
  for (const ConfigNode& child : node.sequence) count += CountOf(child);
  for (const auto& entry : node.mapping) count += CountOf(entry.second);
  return count;
}

std::size_t TextBytesOf(const ConfigNode& node) {
  std::size_t bytes = node.scalar.size();
  for (const ConfigNode& child : node.sequence) bytes += TextBytesOf(child);
  for (const auto& [key, value] : node.mapping) bytes += key.size() + TextBytesOf(value);
  return bytes;
}

ConfigNode ParseYaml(const ConfigSource& source, bool need_mapping, ProblemList& problems) {
  TreeBuilder builder(source, problems);
  if (IsText(source, problems)) RunParser(source, builder, problems);
  if (!need_mapping) return std::move(builder.root);
  ConfigNode root = std::move(builder.root);
  if (builder.has_root && root.kind != ConfigNode::Kind::kMapping && root.kind != ConfigNode::Kind::kNull) {
    problems.Add(root.origin.Text(), "a configuration must be a mapping (lines of 'key: value')");
    root = ConfigNode{};
  }
  if (root.kind != ConfigNode::Kind::kMapping) {
    root.kind = ConfigNode::Kind::kMapping;
    root.origin = {source.name, 1, 1};
    root.base_folder = source.base_folder;
  }
  return root;
}

}  // namespace mocurate::internal
