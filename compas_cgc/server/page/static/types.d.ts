/** Types of the data between page and server, for `tsc --checkJs` only. */

export interface Box {
  x0: number;
  y0: number;
  x1: number;
  y1: number;
  height: number;
}

export interface Goals {
  rise?: number | null;
  above?: number | null;
  below?: number | null;
  found?: boolean;
  edge?: boolean;
  boxes?: Box[];
}

/** A mesh with supports, targets and goals: the response of /api/v1/models, with additions of the page. */
export interface Data {
  name: string;
  unit: string;
  vertices: number[][];
  faces: number[][];
  regions: number[];
  supports: Record<string, number[]>;
  support_choice: string;
  creases: number[][];
  goals: object[];
  targets: (number | null)[];
  vertex_targets?: (number | null)[] | null;
  laws?: Record<string, string>;
  notes: string[];
  problems: { text: string; fatal: boolean; remedies?: Remedy[] }[];
  settings?: Record<string, any>;
  method?: string;
  columns?: number[];
  file?: File | null;
  names?: (string | null)[];
  colours?: (string | null)[];
  heights?: Record<number, number>;
  ground?: number[][];
  wishes?: Goals;
}

export interface State {
  stage: string;
  name: string;
  plan: import('./draw/plan.js').Plan | null;
  data: Data | null;
  solved?: boolean;
  /** the solved surface of the present state */
  solution?: Result | null;
  /** the history of a stored design, and the place of the present state in it */
  states?: State[] | null;
  at?: number;
  /** position of the camera and its target */
  view?: number[] | null;
  /** whether the design may only be viewed */
  only?: boolean;
  revision?: number;
  id?: string;
  time?: number;
}

/** Curvatures per vertex: K as measured by the solver, the others of fitted quadrics. */
export interface Curvatures {
  curvature: Float64Array;
  gaussian: Float64Array;
  mean: Float64Array;
  largest: Float64Array;
  smallest: Float64Array;
}

/** A change that the server proposes; it has one of these fields. */
export interface Remedy {
  text: string;
  change: {
    settings?: Record<string, any>;
    method?: string;
    supports?: string;
    release?: number[];
    targets?: number;
    scale?: number;
    unknown?: string;
    without?: string;
    creases?: number[][][];
    flip?: boolean;
    edge_length?: number;
    edge_scale?: number;
  };
}

/** Status of a job. */
export interface Status {
  id: string;
  state: string;
  stage: string;
  progress: number;
  iteration: number;
  iterations: number | null;
  error: number | null;
  energy: number | null;
  elapsed: number | null;
  message: string;
  remedies?: Remedy[];
  has_result: boolean;
}

export interface Result {
  status: string;
  message: string;
  ending: string;
  iterations: number;
  seconds: number;
  max_error: number;
  method: string;
  xyz: Float64Array;
  /** number of faces that differ from the request */
  turned: number;
  /** corners of all faces, if edges were flipped */
  faces?: Int32Array;
  targets: Float64Array;
  curvature: Float64Array;
  history: { max_error: number[]; energy: number[] };
  report: any;
}

/** Verdict of a surface before it is measured. */
export interface Judged {
  status: string;
  message: string;
  ending: string;
  fair: boolean;
  reasons: string[];
}

/** An option as a JSON schema. */
export interface Option {
  name: string;
  description: string;
  type?: string | string[];
  enum?: (string | null)[];
  default?: any;
  minimum?: number;
  maximum?: number;
  exclusiveMinimum?: number;
  exclusiveMaximum?: number;
}

export interface Method {
  name: string;
  text: string;
  options: Option[];
  formats?: string[];
}

// Properties of various elements of index.html.
declare global {
  interface EventTarget {
    value: any;
    checked: any;
    valueAsNumber: number;
    dataset: DOMStringMap;
    matches(selector: string): boolean;
    defaultValue: string;
    name: string;
  }
  interface Element {
    value: any;
    hidden: any;
    disabled: any;
    style: CSSStyleDeclaration;
    open: any;
    textContent: string;
    scrollIntoView(options?: object): void;
  }
  interface HTMLElement {
    [field: string]: any;
  }
  interface HTMLFormControlsCollection {
    [field: string]: any;
  }
  interface Uint8Array {
    toBase64?(): string;
  }
  interface Uint8ArrayConstructor {
    fromBase64?(text: string): Uint8Array;
  }
}
