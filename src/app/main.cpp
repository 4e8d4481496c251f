// SPDX-License-Identifier: Apache-2.0
// The program `cluxel`.
int main() { return 2; }
