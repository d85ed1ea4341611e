#include "ingest/sense/name_sense.h"

#include <vector>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/formats/ntu_skeleton.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

/// A letter and three digits of a name of NTU RGB+D.
struct NtuField {
  char letter;
  const char* what;
  long long most;
};
constexpr NtuField kNtuFields[] = {
    {'S', "setup", 32}, {'C', "camera", 3}, {'P', "performer", 106}, {'R', "repetition", 2}, {'A', "action", 120}};

/// What a word of a name and a line of a list, counted from 0, have to do with each other.
std::optional<std::string> DoubtWord(const char* what, const std::string& word, int line, const fs::path& list) {
  const Expected<std::string> bytes = ReadFile(list);
  if (!bytes) return std::nullopt;
  const std::string name = DisplayPath(list.filename());
  const Expected<std::vector<std::string>> labels = ParseBandaiLabelList(*bytes, name);
  if (!labels) return std::nullopt;
  const std::string says = std::string("the label's ") + what + " is " + std::to_string(line);
  if (static_cast<std::size_t>(line) >= labels->size())
    return says + ", " + name + " lists " + std::to_string(labels->size()) + " from 0 on";
  const std::string& label = (*labels)[static_cast<std::size_t>(line)];
  if (label == word) return std::nullopt;
  return says + ", '" + label + "' in " + name + ", the name says '" + word + "'";
}

}  // namespace

bool IsNtuActionOfTwo(long long action) { return (action >= 50 && action <= 60) || (action >= 106 && action <= 120); }

std::optional<std::string> DoubtNtuName(const fs::path& path) {
  const std::string name = DisplayPath(path.stem());
  if (name.size() != 4 * std::size(kNtuFields)) return std::nullopt;
  std::vector<long long> numbers;
  for (std::size_t i = 0; i < std::size(kNtuFields); ++i) {
    const std::optional<long long> number = ParseInteger(name.substr(4 * i + 1, 3));
    if (name[4 * i] != kNtuFields[i].letter || !number) return std::nullopt;
    numbers.push_back(*number);
  }
  for (std::size_t i = 0; i < std::size(kNtuFields); ++i) {
    const auto& [letter, what, most] = kNtuFields[i];
    if (numbers[i] >= 1 && numbers[i] <= most) continue;
    return "the name says " + std::string(what) + " " + std::to_string(numbers[i]) + " ('" + name.substr(4 * i, 4) +
           "'): those of NTU RGB+D are 1 to " + std::to_string(most);
  }
  const long long setup = numbers[0], action = numbers[4];
  if ((setup > kLastNtu60Setup) == (action > kLastNtu60Action)) return std::nullopt;
  return "the name says action " + std::to_string(action) + " in setup " + std::to_string(setup) +
         ": in NTU RGB+D setups 1 to 17 have actions 1 to 60, setups 18 to 32 have 61 to 120";
}

std::optional<std::string> DoubtBandaiLabel(const fs::path& path, const BandaiLabel& label) {
  const std::string stem = DisplayPath(path.stem());
  const std::vector<std::string_view> words = SplitText(stem, '_');
  if (words.size() != 4) return std::nullopt;  // set, content, style, number
  const fs::path folder = path.parent_path();
  std::optional<std::string> doubt =
      DoubtWord("content", std::string(words[1]), label.content, folder / "content_label.txt");
  return doubt ? doubt : DoubtWord("style", std::string(words[2]), label.style, folder / "style_label.txt");
}

std::optional<std::string> DoubtName(const fs::path& motion) {
  if (motion.extension() == ".skeleton") return DoubtNtuName(motion);
  std::error_code none;
  const fs::path beside = fs::path(motion).replace_extension(".json");
  if (motion.extension() != ".bvh" || !fs::is_regular_file(beside, none)) return std::nullopt;
  const Expected<std::string> bytes = ReadFile(beside);
  const auto label = bytes ? ParseBandaiLabel(*bytes, DisplayPath(beside.filename())) : Forward(bytes);
  return label ? DoubtBandaiLabel(beside, *label) : std::nullopt;
}

}  // namespace mocurate
