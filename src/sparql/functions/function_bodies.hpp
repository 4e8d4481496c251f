// SPDX-License-Identifier: Apache-2.0
// Declarations of the functions in the function table, by source file.
#pragma once

#include "sparql/functions/functions.hpp"

namespace cluxel::sparql {

// term_functions.cpp
Value strFunction(Arguments arguments, FunctionContext& context);
Value langFunction(Arguments arguments, FunctionContext& context);
Value langMatchesFunction(Arguments arguments, FunctionContext& context);
Value datatypeFunction(Arguments arguments, FunctionContext& context);
Value iriFunction(Arguments arguments, FunctionContext& context);
Value bnodeFunction(Arguments arguments, FunctionContext& context);
Value uuidFunction(Arguments arguments, FunctionContext& context);
Value strUuidFunction(Arguments arguments, FunctionContext& context);
Value strLangFunction(Arguments arguments, FunctionContext& context);
Value strDtFunction(Arguments arguments, FunctionContext& context);
Value sameTermFunction(Arguments arguments, FunctionContext& context);
Value isIriFunction(Arguments arguments, FunctionContext& context);
Value isBlankFunction(Arguments arguments, FunctionContext& context);
Value isLiteralFunction(Arguments arguments, FunctionContext& context);
Value isNumericFunction(Arguments arguments, FunctionContext& context);
Value newObjectFunction(Arguments arguments, FunctionContext& context);

// numeric_functions.cpp
Value absFunction(Arguments arguments, FunctionContext& context);
Value ceilFunction(Arguments arguments, FunctionContext& context);
Value floorFunction(Arguments arguments, FunctionContext& context);
Value roundFunction(Arguments arguments, FunctionContext& context);
Value randFunction(Arguments arguments, FunctionContext& context);

// string_functions.cpp
Value concatFunction(Arguments arguments, FunctionContext& context);
Value strlenFunction(Arguments arguments, FunctionContext& context);
Value ucaseFunction(Arguments arguments, FunctionContext& context);
Value lcaseFunction(Arguments arguments, FunctionContext& context);
Value encodeForUriFunction(Arguments arguments, FunctionContext& context);
Value containsFunction(Arguments arguments, FunctionContext& context);
Value strStartsFunction(Arguments arguments, FunctionContext& context);
Value strEndsFunction(Arguments arguments, FunctionContext& context);
Value strBeforeFunction(Arguments arguments, FunctionContext& context);
Value strAfterFunction(Arguments arguments, FunctionContext& context);
Value substrFunction(Arguments arguments, FunctionContext& context);

// regex_functions.cpp
Value regexFunction(Arguments arguments, FunctionContext& context);
Value replaceFunction(Arguments arguments, FunctionContext& context);

// time_functions.cpp
Value yearFunction(Arguments arguments, FunctionContext& context);
Value monthFunction(Arguments arguments, FunctionContext& context);
Value dayFunction(Arguments arguments, FunctionContext& context);
Value hoursFunction(Arguments arguments, FunctionContext& context);
Value minutesFunction(Arguments arguments, FunctionContext& context);
Value secondsFunction(Arguments arguments, FunctionContext& context);
Value timezoneFunction(Arguments arguments, FunctionContext& context);
Value tzFunction(Arguments arguments, FunctionContext& context);
Value nowFunction(Arguments arguments, FunctionContext& context);

// hash_functions.cpp
Value md5Function(Arguments arguments, FunctionContext& context);
Value sha1Function(Arguments arguments, FunctionContext& context);
Value sha256Function(Arguments arguments, FunctionContext& context);
Value sha384Function(Arguments arguments, FunctionContext& context);
Value sha512Function(Arguments arguments, FunctionContext& context);

// geo_functions.cpp
Value geoDistanceFunction(Arguments arguments, FunctionContext& context);
Value sfIntersectsFunction(Arguments arguments, FunctionContext& context);
Value sfDisjointFunction(Arguments arguments, FunctionContext& context);
Value sfWithinFunction(Arguments arguments, FunctionContext& context);
Value sfContainsFunction(Arguments arguments, FunctionContext& context);
Value sfTouchesFunction(Arguments arguments, FunctionContext& context);
Value envelopeFunction(Arguments arguments, FunctionContext& context);

}  // namespace cluxel::sparql
