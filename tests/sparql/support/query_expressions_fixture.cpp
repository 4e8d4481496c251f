// SPDX-License-Identifier: Apache-2.0
// Random expressions with approximate types. What the specification leaves open (the order of terms of different kinds,
// digits of printed doubles) is not generated.
#include "sparql/support/query_generator_fixture.hpp"

namespace cluxel::test {

std::string QueryGenerator::number(int depth) {
  if (depth <= 0 || chance(35)) {
    if (chance(65)) return variable(kNumbers);
    return one({"0", "1", "3", "-2", "2.5", "0.5", "1.5e0", "10"});
  }
  switch (upTo(13)) {
    case 0:
    case 1:
      return "(" + number(depth - 1) + " + " + number(depth - 1) + ")";
    case 2:
      return "(" + number(depth - 1) + " - " + number(depth - 1) + ")";
    case 3:
      return "(" + number(depth - 1) + " * " + number(depth - 1) + ")";
    case 4:
      return "(" + number(depth - 1) + " / " + one({"2", "4", "0.5", "2.0e0", variable(kNumbers)}) + ")";
    case 5:
      return one({"ABS", "CEIL", "FLOOR", "ROUND"}) + "(" + number(depth - 1) + ")";
    case 6:
      return "STRLEN(" + string(depth - 1) + ")";
    case 7:
      return "IF(" + condition(depth - 1) + ", " + number(depth - 1) + ", " + number(depth - 1) + ")";
    case 8:
      return "COALESCE(" + number(depth - 1) + ", " + number(depth - 1) + ")";
    case 9:
      return "xsd:integer(" + number(depth - 1) + ")";
    case 10:
      return "xsd:decimal(" + variable(kNumbers) + ")";
    case 11:
      return "xsd:double(" + number(depth - 1) + ")";
    default:
      return "-" + variable(kNumbers);
  }
}

std::string QueryGenerator::string(int depth) {
  if (depth <= 0 || chance(30)) {
    if (chance(60)) return variable(kStrings);
    return one({"\"oak\"", "\"Eiche\"@de", "\"\"", "\"Tree\"@en-gb", "\"caf\\u00E9\"", "\"a.b\""});
  }
  switch (upTo(14)) {
    case 0:
      return "STR(" + variable("abkst") + ")";
    case 1:
      return "UCASE(" + string(depth - 1) + ")";
    case 2:
      return "LCASE(" + string(depth - 1) + ")";
    case 3:
      return "CONCAT(" + string(depth - 1) + ", " + string(depth - 1) + ")";
    case 4:
      return "SUBSTR(" + string(depth - 1) + ", " + one({"1", "2", "3"}) + (chance(50) ? ", 2)" : ")");
    case 5:
      return "REPLACE(" + string(depth - 1) + ", " + one({"\"a\"", "\"[a-e]\"", "\"(o)(a)\"", "\"\\\\.\""}) + ", " +
             one({"\"X\"", "\"$0\"", "\"\""}) + ")";
    case 6:
      return "STRBEFORE(" + string(depth - 1) + ", " + one({"\"a\"", "\" \"", "\"\"", "\"zz\""}) + ")";
    case 7:
      return "STRAFTER(" + string(depth - 1) + ", " + one({"\"a\"", "\" \"", "\"\"", "\"zz\""}) + ")";
    case 8:
      return "LANG(" + anyVariable() + ")";
    case 9:
      return "STR(DATATYPE(" + anyVariable() + "))";
    case 10:
      return "IF(" + condition(depth - 1) + ", " + string(depth - 1) + ", " + string(depth - 1) + ")";
    case 11:
      return "COALESCE(" + string(depth - 1) + ", " + string(depth - 1) + ")";
    case 12:
      return "ENCODE_FOR_URI(" + string(depth - 1) + ")";
    default:
      return one({"MD5", "SHA1", "SHA256"}) + "(STR(" + string(depth - 1) + "))";
  }
}

std::string QueryGenerator::anything(int depth) {
  switch (upTo(8)) {
    case 0:
      return number(depth - 1);
    case 1:
      return string(depth - 1);
    case 2:
      return "IRI(STR(" + variable("abk") + "))";
    case 3:
      return "STRLANG(STR(" + string(depth - 1) + "), \"de\")";
    case 4:
      return "STRDT(STR(" + string(depth - 1) + "), clx:serial)";
    case 5:
      return "DATATYPE(" + anyVariable() + ")";
    case 6:
      return "COALESCE(" + anyVariable() + ", \"none\")";
    default:
      return anyVariable();
  }
}

std::string QueryGenerator::comparison(int depth) {
  switch (upTo(4)) {
    case 0:
      return "(" + string(depth - 1) + one({" = ", " != "}) + string(depth - 1) + ")";
    case 1:
      return "(" + anything(depth - 1) + one({" = ", " != "}) + anything(depth - 1) + ")";
    default:
      return "(" + number(depth - 1) + one({" < ", " > ", " <= ", " >= ", " = ", " != "}) + number(depth - 1) + ")";
  }
}

std::string QueryGenerator::test(int depth) {
  switch (upTo(12)) {
    case 0:
      return "BOUND(" + anyVariable() + ")";
    case 1:
      return one({"isIRI", "isBlank", "isLiteral", "isNumeric"}) + "(" + anyVariable() + ")";
    case 2:
      return one({"CONTAINS", "STRSTARTS", "STRENDS"}) + "(" + string(depth - 1) + ", " +
             one({"\"a\"", "\"\"", "\"e\"@de", "\"oak\""}) + ")";
    case 3:
      return "REGEX(" + string(depth - 1) + ", " + one({"\"^o\"", "\"e$\"", "\"[A-Z]\"", "\"a.b\"", "\"\u00e9\""}) +
             (chance(40) ? ", \"i\")" : ")");
    case 4:
      return "LANGMATCHES(LANG(" + variable(kStrings) + "), " + one({"\"de\"", "\"en\"", "\"*\"", "\"EN-GB\""}) + ")";
    case 5:
      return "sameTerm(" + anything(1) + ", " + anything(1) + ")";
    case 6:
      return "(" + variable("ab") + one({" IN ", " NOT IN "}) + "(o:1, o:2, " + variable("abc") + "))";
    case 7:
      return "(" + number(depth - 1) + one({" IN ", " NOT IN "}) + "(1, 2.5, " + number(depth - 1) + "))";
    case 8:
      return "(DATATYPE(" + anyVariable() + ") = " + one({"xsd:integer", "xsd:string", "xsd:double", "clx:serial"}) +
             ")";
    case 9:
      return variable("f");
    case 10:
      return exists();
    default:
      return comparison(depth);
  }
}

std::string QueryGenerator::condition(int depth) {
  if (depth <= 0 || chance(55)) return test(1);
  switch (upTo(4)) {
    case 0:
      return "(" + condition(depth - 1) + " && " + condition(depth - 1) + ")";
    case 1:
      return "(" + condition(depth - 1) + " || " + condition(depth - 1) + ")";
    case 2:
      return "!(" + condition(depth - 1) + ")";
    default:
      return test(2);
  }
}

}  // namespace cluxel::test
