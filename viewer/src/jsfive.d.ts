// What the page uses of jsfive, which has no types of its own.
declare module "jsfive" {
  export class Dataset {
    readonly shape: number[];
    readonly dtype: unknown;
    readonly value: ArrayLike<number> | ArrayLike<bigint> | ArrayLike<string> | string;
  }
  export class File {
    constructor(bytes: ArrayBuffer, name: string);
    readonly attrs: Record<string, unknown>;
    get(path: string): unknown;
  }
}
