// SPDX-License-Identifier: Apache-2.0
// The ranges of name characters above 127.
#include "sparql/syntax/character_class.hpp"

#include <algorithm>

namespace cluxel::sparql::character {

namespace {

struct Range {
  std::uint32_t first, last;
};

constexpr std::array<Range, 12> kNameStart{{{0xC0, 0xD6},
                                            {0xD8, 0xF6},
                                            {0xF8, 0x2FF},
                                            {0x370, 0x37D},
                                            {0x37F, 0x1FFF},
                                            {0x200C, 0x200D},
                                            {0x2070, 0x218F},
                                            {0x2C00, 0x2FEF},
                                            {0x3001, 0xD7FF},
                                            {0xF900, 0xFDCF},
                                            {0xFDF0, 0xFFFD},
                                            {0x10000, 0xEFFFF}}};

}  // namespace

bool isNameStart(std::uint32_t code_point) {
  return std::any_of(kNameStart.begin(), kNameStart.end(), [code_point](const Range& range) {
    return code_point >= range.first && code_point <= range.last;
  });
}

bool isNameExtra(std::uint32_t code_point) {
  return code_point == 0xB7 || (code_point >= 0x300 && code_point <= 0x36F) || code_point == 0x203F ||
         code_point == 0x2040;
}

}  // namespace cluxel::sparql::character
