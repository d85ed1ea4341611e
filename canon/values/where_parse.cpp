#include <algorithm>
#include <cctype>
#include <cmath>
#include <string_view>

#include "canon/values/where_nodes.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

using Node = Condition::Node;

constexpr int kDeepest = 100;              // brackets and nots inside each other
constexpr std::size_t kMostTests = 10000;  // each looks at every clip

constexpr std::pair<const char*, Node::Test> kTests[] = {
    {"==", Node::Test::kEqual},     {"!=", Node::Test::kNotEqual}, {"=~", Node::Test::kMatches},
    {"<=", Node::Test::kLessEqual}, {"<", Node::Test::kLess},      {">=", Node::Test::kGreaterEqual},
    {">", Node::Test::kGreater}};

// glibc copies what + and {counts} repeat, and stores for each copy its successors: without a limit, 60 bytes of
// pattern use gigabytes.
constexpr std::size_t kLongestPattern = 128;  // bytes
constexpr double kMostCopies = 64.0;

/// Maximum copies of a part of a pattern by nested + and {counts}; empty for back references.
std::optional<double> CopiesOf(const std::string& pattern) {
  double copies = 1.0;
  for (std::size_t at = 0; at < pattern.size(); ++at) {
    if (pattern[at] == '\\') {
      ++at;
      if (at < pattern.size() && pattern[at] >= '1' && pattern[at] <= '9') return std::nullopt;
    } else if (pattern[at] == '+') {
      copies *= 2.0;
    } else if (pattern[at] == '{') {
      double most = 0.0, count = 0.0;
      for (++at; at < pattern.size() && pattern[at] != '}'; ++at) {
        const char c = pattern[at];
        count = c >= '0' && c <= '9' ? 10.0 * count + (c - '0') : 0.0;
        most = std::max(most, count);
      }
      copies *= most + 1.0;
    }
  }
  return copies;
}

/// A POSIX extended regular expression. Error kUsage without a place for an invalid expression, and for those with
/// unbounded time or memory: back references and large or nested counts.
Expected<std::shared_ptr<const regex_t>> CompilePattern(const std::string& text) {
  const auto copies = CopiesOf(text);
  if (!copies) return Fail(ErrorCode::kUsage, "a regular expression with back references is refused");
  if (text.size() > kLongestPattern || !(*copies <= kMostCopies)) {
    return Fail(ErrorCode::kUsage,
                "the regular expression is too large: " + std::to_string(text.size()) + " bytes of at most " +
                    std::to_string(kLongestPattern) + ", + and {counts} make " + RoundedText(*copies) +
                    " copies of at most " + RoundedText(kMostCopies),
                "use * instead of +, or join two tests by 'and'");
  }
  auto pattern = std::make_unique<regex_t>();
  if (const int failed = ::regcomp(pattern.get(), text.c_str(), REG_EXTENDED | REG_NOSUB); failed != 0) {
    char reason[200] = {};
    ::regerror(failed, pattern.get(), reason, sizeof reason);
    return Fail(ErrorCode::kUsage, "'" + text + "' is not a regular expression: " + reason,
                "POSIX extended: . [a-z] * + ? {2,3} ( | ) ^ $");
  }
  return std::shared_ptr<const regex_t>(pattern.release(), [](const regex_t* compiled) {
    ::regfree(const_cast<regex_t*>(compiled));
    delete compiled;
  });
}

const std::vector<ConditionField>& ConditionFields() {
  static const std::vector<ConditionField> fields = {
      {"id", true, nullptr},       {"label", true, nullptr},       {"fine_label", true, nullptr},
      {"person", true, nullptr},   {"recording", true, nullptr},   {"session", true, nullptr},
      {"view", true, nullptr},     {"source", true, nullptr},      {"role", true, nullptr},
      {"licence", true, nullptr},  {"part", true, "SPLIT"},        {"provenance", true, "KEY"},
      {"frames", false, nullptr},  {"seconds", false, nullptr},    {"rate", false, nullptr},
      {"fit_rms", false, nullptr}, {"confidence", false, nullptr}, {"findings", false, "CODE"},
      {"segments", false, "LABEL"}};
  return fields;
}

struct Token {
  enum class Kind { kWord, kQuoted, kSign, kEnd };
  Kind kind = Kind::kEnd;
  std::string text;  ///< of kQuoted: the text between the quotes
  std::size_t begin = 0, end = 0;

  bool Is(const char* word) const { return text == word && (kind == Kind::kWord || kind == Kind::kSign); }
  /// For messages.
  std::string Shown() const { return kind == Kind::kEnd ? "the end" : "'" + text + "'"; }
};

bool IsWordByte(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return std::isalnum(byte) != 0 || byte >= 0x80 || std::string_view("_-./#:+@").find(c) != std::string_view::npos;
}

class ConditionParser {
 public:
  ConditionParser(const std::string& text, const std::string& place) : text_(text), place_(place) {}

  Expected<Node> Whole() {
    if (Status read = Advance(); !read) return Forward(read);
    auto node = Or(0);
    if (!node) return node;
    if (token_.kind == Token::Kind::kEnd) return node;
    const bool sign = token_.Is("&&") || token_.Is("||");
    return Wrong(token_.begin, token_.Shown() + " was not expected here",
                 sign ? "write 'and' and 'or'" : "join tests by 'and' or 'or'; put a value with blanks into quotes");
  }

 private:
  tl::unexpected<Error> Wrong(std::size_t byte, const std::string& what, const std::string& hint = "") const {
    return Fail(ErrorCode::kUsage, what, place_ + ":" + std::to_string(ColumnOf(text_, byte)), hint);
  }

  /// Reads the next token.
  Status Advance() {
    std::size_t at = token_.end;
    while (at < text_.size() && std::isspace(static_cast<unsigned char>(text_[at])) != 0) ++at;
    token_ = {Token::Kind::kEnd, "", at, at};
    if (at == text_.size()) return {};
    std::size_t end = at;
    if (text_[at] == '\'' || text_[at] == '"') {
      end = text_.find(text_[at], at + 1);
      if (end == std::string::npos) return Wrong(at, "the quote is not closed");
      token_ = {Token::Kind::kQuoted, text_.substr(at + 1, end - at - 1), at, end + 1};
      return {};
    }
    while (end < text_.size() && IsWordByte(text_[end])) ++end;
    if (end > at) {
      token_ = {Token::Kind::kWord, text_.substr(at, end - at), at, end};
      return {};
    }
    for (const char* sign : {"==", "!=", "=~", "<=", ">=", "&&", "||", "<", ">", "(", ")", "[", "]", ",", "=", "!"}) {
      if (text_.compare(at, std::char_traits<char>::length(sign), sign) != 0) continue;
      token_ = {Token::Kind::kSign, sign, at, at + std::char_traits<char>::length(sign)};
      return {};
    }
    return Wrong(at, std::string("'") + text_[at] + "' is not allowed in a condition", "put texts into quotes");
  }

  /// Parts joined by one word.
  template <class Part>
  Expected<Node> Joined(const char* word, Node::Kind kind, const Part& part) {
    auto first = part();
    if (!first || !token_.Is(word)) return first;
    Node node;
    node.kind = kind;
    node.parts.push_back(std::move(*first));
    while (token_.Is(word)) {
      if (Status read = Advance(); !read) return Forward(read);
      auto next = part();
      if (!next) return next;
      node.parts.push_back(std::move(*next));
    }
    return node;
  }

  Expected<Node> Or(int depth) {
    return Joined("or", Node::Kind::kOr, [&] { return Joined("and", Node::Kind::kAnd, [&] { return One(depth); }); });
  }

  Expected<Node> One(int depth) {
    const Token first = token_;
    if (depth > kDeepest) return Wrong(first.begin, "more than " + std::to_string(kDeepest) + " brackets are open");
    if (!first.Is("not") && !first.Is("(")) return Test();
    if (Status read = Advance(); !read) return Forward(read);
    if (first.Is("not")) {
      auto inner = One(depth + 1);
      if (!inner) return inner;
      Node node;
      node.kind = Node::Kind::kNot;
      node.parts.push_back(std::move(*inner));
      return node;
    }
    auto inner = Or(depth + 1);
    if (!inner) return inner;
    if (!token_.Is(")")) return Wrong(first.begin, "the bracket is not closed");
    if (Status read = Advance(); !read) return Forward(read);
    return inner;
  }

  Expected<Node> Test() {
    Node node;
    node.begin = token_.begin;
    if (++tests_ > kMostTests) {
      return Wrong(node.begin, "more than " + std::to_string(kMostTests) + " comparisons",
                   "compare with a list: id in [a, b]");
    }
    if (Status field = ReadField(node); !field) return Forward(field);
    const Token sign = token_;
    const auto* test =
        std::find_if(std::begin(kTests), std::end(kTests), [&](const auto& t) { return sign.Is(t.first); });
    const bool negated = sign.Is("not");
    if (test == std::end(kTests) && !negated && !sign.Is("in")) {
      return Wrong(sign.begin, "a comparison is expected after '" + std::string(node.field->name) + "'",
                   sign.Is("=") ? "did you mean '=='?" : "one of == != < <= > >= =~ in, not in");
    }
    if (Status read = Advance(); !read) return Forward(read);
    if (negated && !token_.Is("in")) return Wrong(token_.begin, "'in' is expected after 'not'");
    if (negated) {
      if (Status read = Advance(); !read) return Forward(read);
    }
    node.test = test != std::end(kTests) ? test->second : negated ? Node::Test::kNotIn : Node::Test::kIn;
    const bool orders = node.test >= Node::Test::kLess && node.test <= Node::Test::kGreaterEqual;
    if (node.field->is_text && orders) {
      return Wrong(sign.begin, "'" + std::string(node.field->name) + "' is a text, which has no order",
                   "== != =~ in, not in compare texts");
    }
    if (!node.field->is_text && node.test == Node::Test::kMatches) {
      return Wrong(sign.begin, "'" + std::string(node.field->name) + "' is a number, =~ compares texts only");
    }
    const bool list = test == std::end(kTests);
    if (list && !token_.Is("[")) return Wrong(token_.begin, "a list is expected after 'in'", "in [walk, run]");
    do {
      if (list) {
        if (Status read = Advance(); !read) return Forward(read);
      }
      if (Status value = ReadValue(node); !value) return Forward(value);
    } while (list && token_.Is(","));
    if (list) {
      if (!token_.Is("]")) return Wrong(token_.begin, "',' or ']' is expected in the list");
      node.end = token_.end;
      if (Status read = Advance(); !read) return Forward(read);
    }
    return node;
  }

  Status ReadField(Node& node) {
    std::vector<std::string> names;
    for (const ConditionField& field : ConditionFields()) {
      names.emplace_back(field.name);
      if (token_.Is(field.name)) node.field = &field;
    }
    if (node.field == nullptr) {
      const std::string all = "fields: " + JoinTexts(names, " ");
      return Wrong(token_.begin, token_.Shown() + " is not a field of a clip",
                   token_.kind == Token::Kind::kWord ? DidYouMean(token_.text, names, all) : all);
    }
    if (Status read = Advance(); !read) return read;
    if (node.field->argument == nullptr) return {};
    const std::string spelled = std::string(node.field->name) + "('" + node.field->argument + "')";
    if (!token_.Is("(")) return Wrong(token_.begin, "'" + std::string(node.field->name) + "' needs brackets", spelled);
    if (Status read = Advance(); !read) return read;
    if (token_.kind != Token::Kind::kWord && token_.kind != Token::Kind::kQuoted) {
      return Wrong(token_.begin, "a text is expected in the brackets", spelled);
    }
    node.argument = token_.text;
    if (Status read = Advance(); !read) return read;
    return token_.Is(")") ? Advance() : Wrong(token_.begin, "')' is expected", spelled);
  }

  Status ReadValue(Node& node) {
    const Token value = token_;
    if (value.kind != Token::Kind::kWord && value.kind != Token::Kind::kQuoted) {
      return Wrong(value.begin, "a value is expected, not " + value.Shown());
    }
    node.end = value.end;
    if (!node.field->is_text) {
      const auto number = NumberOf(value.text);
      if (!number)
        return Wrong(value.begin, "'" + value.text + "' is not a number, which " + node.field->name + " needs");
      node.numbers.push_back(*number);
    } else if (node.test == Node::Test::kMatches) {
      auto pattern = CompilePattern(value.text);
      if (!pattern) return Wrong(value.begin, pattern.error().what, pattern.error().hint);
      node.pattern = std::move(*pattern);
    } else {
      const std::vector<std::string> parts = {"train", "validation", "test", ""};
      if (std::string_view(node.field->name) == "part" &&
          std::find(parts.begin(), parts.end(), value.text) == parts.end()) {
        return Wrong(value.begin, "'" + value.text + "' is not a part of a split",
                     DidYouMean(value.text, parts, "train, validation, test, or '' for none"));
      }
      node.texts.push_back(value.text);
    }
    Status read = Advance();
    const bool cut = read && node.pattern && token_.kind == Token::Kind::kSign && token_.begin == value.end;
    if (!cut || token_.Is(")")) return read;
    return Wrong(token_.begin, "the regular expression ends here", "put it into quotes");
  }

  /// "60", "2.5", "30000/1001"
  static std::optional<double> NumberOf(const std::string& text) {
    const std::size_t slash = text.find('/');
    const auto above = ParseDouble(std::string_view(text).substr(0, slash));
    const auto below = slash == std::string::npos ? 1.0 : ParseDouble(std::string_view(text).substr(slash + 1));
    if (!above || !below || !std::isfinite(*above / *below)) return std::nullopt;
    return *above / *below;
  }

  const std::string& text_;
  const std::string& place_;
  Token token_;
  std::size_t tests_ = 0;
};

}  // namespace

std::size_t ColumnOf(const std::string& text, std::size_t byte) {
  const auto begin = text.begin(), end = begin + static_cast<std::ptrdiff_t>(std::min(byte, text.size()));
  return 1 + static_cast<std::size_t>(
                 std::count_if(begin, end, [](char c) { return (static_cast<unsigned char>(c) & 0xc0u) != 0x80u; }));
}

Expected<Condition> Condition::Parse(const std::string& text, const std::string& place) {
  auto root = ConditionParser(text, place).Whole();
  if (!root) return Forward(root);
  return Condition(text, place, std::make_shared<const Node>(std::move(*root)));
}

}  // namespace mocurate
