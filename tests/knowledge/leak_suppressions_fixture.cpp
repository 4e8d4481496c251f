// SPDX-License-Identifier: Apache-2.0
// Raptor 2.0.15 forgets the datatype of some literals and the terms of faulty lines; LeakSanitizer shall look
// past those.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libraptor2\n";
}
