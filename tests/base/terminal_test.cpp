// Texts that are not ours on terminals.

#include "core/base/terminal.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/base/log.h"

namespace mocurate {
namespace {

constexpr const char* kHostile = "a\x1b[2J\x1b]0;t\x07\x7f\r\xC2\x9B\xE2\x80\xAE\xE2\x81\xA6\xD8\x9C\xFF";
constexpr const char* kShown =
    "a\\x1b[2J\\x1b]0;t\\x07\\x7f\\x0d\\xc2\\x9b\\xe2\\x80\\xae\\xe2\\x81\\xa6\\xd8\\x9c\\xff";

TEST(Terminal, GetsNoControlCharacterNoMarkOfDirectionAndOnlyUtf8) {
  EXPECT_EQ(TerminalText(kHostile), kShown);
  EXPECT_EQ(TerminalText("a\tb\nc"), "a\tb\nc");
  EXPECT_EQ(TerminalLine("a\tb\nc"), "a\\x09b\\x0ac");
  const std::string plain = "gr\xC3\xBC\xC3\x9F \xE8\xA1\x8C \xF0\x9F\x99\x82 \xC2\xA0 \xE2\x80\x93";
  EXPECT_EQ(TerminalText(plain), plain);
  EXPECT_EQ(TerminalText("\xE2\x80"), "\\xe2\\x80") << "cut off";
  EXPECT_EQ(TerminalText(""), "");
}

TEST(Terminal, EscapesWhatIsPrintedAndLogged) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  Print("%s %-4s|%d\n", kHostile, "x", 3);
  PrintLine(kHostile);
  PrintError(kHostile);
  LogWarning(kHostile);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), std::string(kShown) + " x   |3\n" + kShown + "\n");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), std::string(kShown) + "warning: " + kShown + "\n");
}

TEST(Terminal, GetsJsonThatIsAsciiAndReadsBack) {
  const nlohmann::json document = {{"name", "\x1b \x7f \xC2\x9B \xE2\x80\xAE gr\xC3\xBC\xC3\x9F \\"}};
  testing::internal::CaptureStdout();
  PrintJson(document);
  PrintJson({{"bytes", "\xFF"}}, -1);
  const std::string text = testing::internal::GetCapturedStdout();
  for (const char c : text) EXPECT_TRUE(c == '\n' || (c >= 0x20 && c < 0x7F)) << int(c);
  const std::size_t second = text.rfind("\n", text.size() - 2);
  EXPECT_EQ(nlohmann::json::parse(text.substr(0, second)), document);
  EXPECT_EQ(text.substr(second), "\n{\"bytes\":\"\\ufffd\"}\n");
}

}  // namespace
}  // namespace mocurate
