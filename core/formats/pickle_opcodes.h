#pragma once

#include <string_view>

namespace mocurate {

/// Whether the bytes begin as a pickle of protocol 0 or 1, which has no magic number: whether they are opcodes with
/// arguments of their form, up to the end of `head` (the end of a pickle has to be the last byte). What the opcodes
/// would do is not asked: names of classes and opcodes that ParsePickle refuses are opcodes too.
bool BeginsAsOldPickle(std::string_view head);

}  // namespace mocurate
