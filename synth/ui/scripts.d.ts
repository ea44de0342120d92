// What scripts of reports find in their page: numbers.js stands before them. Read by the checks only.

declare const number: typeof import("./numbers.js").number;
declare const usedShare: typeof import("./numbers.js").usedShare;
